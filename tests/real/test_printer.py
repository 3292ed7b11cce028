"""A printer's frame: 530 mm of aluminium would rise 12.4 um a kelvin; measured are -33."""

import pytest

from benchmarks.real import printer

pytestmark = pytest.mark.slow

DAYS = list(printer.FILES)


@pytest.mark.parametrize("day", DAYS)
def test_expansion_is_refused_where_the_library_holds_nothing_else(day: str) -> None:
    result = printer.warmed(day, expansion_only=True)
    assert result.verdict == "unknown"
    assert result.findings == ()
    reasons = [form.reason for form in result.rejected_forms if form.effect == printer.EXPANSION]
    assert reasons == ["only a size below what is possible would fit"]


@pytest.mark.parametrize("day", DAYS)
def test_expansion_alone_is_refused(day: str) -> None:
    result = printer.warmed(day)
    assert result.verdict in ("named", "alias_class", "unknown")
    assert printer.refused(result)
    falls = [p.value for f in result.findings for p in f.parameters if p.parameter == "per_kelvin"]
    assert falls
    assert sum(falls) == pytest.approx(-33e-6, abs=8e-6)
