"""CasADi's symbols, where formulas are written down for it."""

from __future__ import annotations

from typing import Any


def column_of_symbols(name: str, size: int = 1) -> Any:
    """A column of CasADi symbols (size, 1), which NumPy's functions give expressions of as well: a separate formula
    may use `np.sin` where the project has `sections.numeric.sin`.

    CasADi (from 3.8 on) warns of that at length unless it is told that it is meant; whoever told it otherwise is left
    alone.
    """
    import casadi as ca

    options: Any = ca.GlobalOptions
    if hasattr(options, "setNumpyMode") and options.getNumpyMode() == 0:
        options.setNumpyMode(-1)
    return ca.SX.sym(name, size)  # pyright: ignore[reportCallIssue]
