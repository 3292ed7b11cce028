"""What does the model of an arm leave out? A recording of its tip says it: backlash, where, how much, how sure."""

import plotly.graph_objects as go

import linkwright as lw

arm = lw.read_arm("examples/hidden-backlash/arm.yaml")
dia = lw.diagnose(arm, "examples/hidden-backlash/recording.csv")
print(dia.sentence)
figure = go.Figure(layout={"xaxis_title": "joint 2 in degrees", "yaxis_title": "tip beside the model in mm"})
for name, each in (("as given", arm), ("corrected", dia.corrected)):
    left = lw.predict(each, dia.recording).table
    figure.add_scatter(x=left["q2_deg"], y=left["residual_mm"], mode="markers", name=name)
