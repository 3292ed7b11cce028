"""What forms are called."""

from types import MappingProxyType

from linkwright.core.diagnose.patterns.form import COLUMN, sentence_of
from linkwright.core.diagnose.patterns.library import Candidate


def test_a_form_that_follows_a_column_says_which():
    of_bed = Candidate(COLUMN.name, (), ("x", "y"), MappingProxyType({"bed_t": 0.0}))
    assert sentence_of(of_bed) == "something that follows the column bed_t"
