"""The report: one self-contained page, no network, charts drawn on canvases by the page's own script."""
