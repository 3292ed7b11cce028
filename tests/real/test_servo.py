"""A servo's backlash, as its publishers measured it: 14.78 counts pulled, 7.03 after the pull, of 4096 a turn."""

import pytest

from benchmarks.real import servo

pytestmark = pytest.mark.slow


def test_backlash_loaded() -> None:
    result = servo.loaded()
    assert result.findings[0].effect == "backlash"
    assert servo.counts(result) == pytest.approx(servo.PUBLISHED["loaded"], abs=0.2)


def test_backlash_unloaded() -> None:
    assert servo.counts(servo.unloaded()) == pytest.approx(servo.PUBLISHED["unloaded"], abs=0.2)


def test_plain_averages_are_the_published_ones() -> None:
    averages = servo.averages()
    assert averages["pulled, 300 counts and more"] == pytest.approx(servo.PUBLISHED["loaded"], abs=0.2)
    assert averages["after the pull"] == pytest.approx(servo.PUBLISHED["unloaded"], abs=0.2)
