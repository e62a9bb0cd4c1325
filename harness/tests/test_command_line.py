"""The command line as the harness calls it."""

import pytest

from switchid_harness import hidden, improvement
from switchid_harness.command_line import CommandFailed, CommandLine


def test_a_command_that_fails_says_what_and_why(command, tmp_path):
    with pytest.raises(CommandFailed, match=r"(?s)compare none.csv.*none.csv"):
        (tmp_path / "model.toml").write_text(improvement.model_text("m", {"qdd": "fit"}))
        CommandLine(command, tmp_path).json("compare", "none.csv", "--model", "model.toml")


@pytest.mark.parametrize(("start", "kind"), [(b"PAR1", "Parquet"), (b"MATLAB 5.0 MAT-file", "MAT")])
def test_a_build_without_formats_names_the_feature(command, tmp_path, start, kind):
    (tmp_path / "record").write_bytes(start + bytes(600))
    (tmp_path / "model.toml").write_text(improvement.model_text("m", {"qdd": "fit"}))
    with pytest.raises(CommandFailed, match=rf"{kind}.*feature \"formats\""):
        CommandLine(command, tmp_path).json("compare", "record", "--model", "model.toml")


def test_a_build_without_pictures_refuses_one_before_any_work(command, tmp_path):
    arguments = ["improve", "none.csv", "--model", "none.toml", "-o", "better.toml", "--picture", "stairs.svg"]
    with pytest.raises(CommandFailed, match="stairs.svg.*feature \"pictures\""):
        CommandLine(command, tmp_path).json(*arguments)


def test_a_models_plant_is_driven_as_the_plant_is(fmus, command, tmp_path):
    scenario = hidden.drawn(4)[0]
    found = improvement.perform(scenario, fmus, command, tmp_path)
    for motion in found.run.predicted.values():
        assert motion[:, 2].tobytes() == found.run.measured[:, 2].tobytes()
        assert motion[0, :2] == pytest.approx(found.run.truth[0])
    assert found.figures["passed"], found.figures["gates"]
    assert (found.run.measured[:, 0] - found.run.truth[:, 0]).std() == pytest.approx(scenario.noise, rel=0.05)
