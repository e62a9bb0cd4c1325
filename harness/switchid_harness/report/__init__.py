"""The report: one self-contained page, no network; plotly, which the page holds, draws its figures."""
