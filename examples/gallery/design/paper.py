"""Table IV of the paper, backlash of the welding arm: as its equations read, and with all that follows turning too."""

import plotly.graph_objects as go

import linkwright as lw

table = lw.paper_tables(quick=True)["backlash"]
print(table[["label", "paper_1", "as_equations_read_mm_1", "corrected_mm_1"]].to_string(index=False))
figure = go.Figure(layout={"barmode": "group", "yaxis_title": "worst error in mm"})
figure.add_bar(x=table["label"], y=table["as_equations_read_mm_1"], name="as the equations read")
figure.add_bar(x=table["label"], y=table["corrected_mm_1"], name="corrected")
