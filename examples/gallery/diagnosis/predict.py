"""Is a corrected arm right where nobody learned it? Half of the rows are learned from, the other half is predicted."""

import pandas as pd
import plotly.graph_objects as go

import linkwright as lw

arm = lw.read_arm("examples/hidden-backlash/arm.yaml")
rows = pd.read_csv("examples/hidden-backlash/recording.csv")
learned, fresh = rows[: len(rows) // 2], rows[len(rows) // 2 :]
dia = lw.diagnose(arm, learned)
figure = go.Figure(layout={"barmode": "overlay", "xaxis_title": "what is left in mm", "yaxis_title": "readings"})
for name, each in (("as given", arm), ("corrected", dia.corrected)):
    said = lw.predict(each, fresh)
    print(f"{name}: {said.rms_mm:.4f} mm RMS of rows that nothing was fitted to")
    figure.add_histogram(x=said.table["residual_mm"], name=name, xbins={"size": 0.005})
