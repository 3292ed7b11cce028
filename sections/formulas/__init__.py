"""Torsion, shear, plastic moduli and fillets: formulas that several shapes share, and the solver behind them."""
