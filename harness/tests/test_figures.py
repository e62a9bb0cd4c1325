"""The figures on arrays whose answers are worked out by hand; no case is symmetric in what it tests."""

import numpy as np
import pytest

from switchid_harness.figures import LEVEL, alarm_times, coefficient_error, detections, tracking_delay


def test_coefficient_error_counts_wrong_extra_and_missing_terms():
    truth = np.array([2.0, -1.0, 0.0, 4.0])
    found = np.array([[2.5, -1.0, 0.25, 3.0], [2.0, 1.0, 0.0, 0.0]])
    assert coefficient_error(found, truth) == pytest.approx([(0.25 + 0.0625 + 1.0) / 21.0, (4.0 + 16.0) / 21.0])


def test_every_count_is_an_alarm():
    count = np.array([0, 0, 1, 1, 3, 3])
    time = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    assert alarm_times(count, time) == [0.3, 0.5, 0.5]


def test_a_count_that_begins_above_zero_is_an_alarm():
    assert alarm_times(np.array([1, 1]), np.array([0.5, 0.6])) == [0.5]


def test_first_alarm_after_a_switch_detects_it_and_all_others_are_false():
    found = detections([0.5, 10.2, 11.0, 31.5, 39.0], [10.0, 20.0, 30.0])
    assert found.times == [10.2, None, 31.5]
    assert found.false_alarms == [0.5, 11.0, 39.0]
    assert found.missed == 1


def test_an_alarm_at_the_instant_of_the_switch_belongs_to_the_law_before():
    found = detections([10.0, 20.0], [10.0])
    assert found.times == [20.0] and found.false_alarms == [10.0]


def test_alarms_without_a_switch_are_false():
    found = detections([3.0], [])
    assert found.times == [] and found.false_alarms == [3.0] and found.missed == 0


def _error(values: list[float]) -> tuple[np.ndarray, np.ndarray]:
    return np.array(values), np.arange(1, len(values) + 1) * 0.5


def test_tracking_delay_counts_from_the_last_excursion():
    error, time = _error([1.0, 1.0, 1e-4, 1.0, 1e-4, 1e-5, 9.0, 9.0])
    assert tracking_delay(error, time, start=0.5, end=3.0) == pytest.approx(2.0)


def test_tracking_delay_of_a_law_that_is_lost_again_at_the_end_is_none():
    error, time = _error([1.0, 1e-4, 1e-4, 1.0])
    assert tracking_delay(error, time, start=0.0, end=2.0) is None


def test_tracking_delay_needs_less_than_the_level_and_no_nan():
    at_level, time = _error([LEVEL, LEVEL, LEVEL])
    assert tracking_delay(at_level, time, 0.0, 1.5) is None
    with_nan, time = _error([1e-9, np.nan, 1e-9])
    assert tracking_delay(with_nan, time, 0.0, 1.5) == pytest.approx(1.5)


def test_tracking_delay_of_a_law_that_was_never_wrong_is_zero():
    error, time = _error([1e-9, 1e-9, 1e-9])
    assert tracking_delay(error, time, 0.0, 1.5) == 0.0
