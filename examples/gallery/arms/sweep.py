"""Worst error over the wall of a tube, for three payloads: a table of many variants, drawn."""

import plotly.graph_objects as go

import linkwright as lw

walls = [f"{wall / 2} mm" for wall in range(3, 17)]
wall, payload = "chain[1].link.section.thickness", "payload.mass"
table = lw.sweep("examples/bench-arm/arm.yaml", {wall: walls, payload: ["1 kg", "2 kg", "3 kg"]})
print(f"{len(table)} variants, the best {table['max_error_mm'].min():.3f} mm")

figure = go.Figure(layout={"xaxis_title": "mass of the links in kg", "yaxis_title": "worst error in mm"})
for name, rows in table.groupby(payload):
    figure.add_scatter(x=rows["mass_kg"], y=rows["max_error_mm"], mode="lines+markers", name=f"{name} payload")
