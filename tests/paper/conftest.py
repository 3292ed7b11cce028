"""The paper's tables and figures, computed once for all tests."""

import pytest

from linkwright.paper.output.figures import make_figures
from linkwright.paper.tables import make_tables


@pytest.fixture(scope="session")
def book():
    """Tables III to VII."""
    return make_tables()


@pytest.fixture(scope="session")
def figures():
    """Figures 5 to 9 by number, coarser than the command makes them."""
    return {figure.number: figure for figure in make_figures(rings=16, spokes=48, points=9)}
