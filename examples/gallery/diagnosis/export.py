"""What was found goes into one's own URDF, every other byte stays; the corrected file is held against the readings."""

from pathlib import Path
from tempfile import TemporaryDirectory

import plotly.graph_objects as go

import linkwright as lw

urdf = "examples/urdf/tabletop.urdf"
arm = lw.read_arm(urdf, tip="tip")
recording = lw.simulate(arm, poses=20, repeats=2, with_=[{"effect": "encoder_offset", "at": 2, "offset": "0.3 deg"}])
found = lw.diagnose(arm, recording)
figure = go.Figure(layout={"xaxis_title": "reading", "yaxis_title": "tip off by, mm", "yaxis_type": "log"})
with TemporaryDirectory() as folder:
    corrected = Path(folder) / "corrected.urdf"
    corrected.write_text(lw.export_arm(found.corrected, into=urdf).text, encoding="utf-8")
    for name, file in (("your URDF", urdf), ("corrected", corrected)):
        said = lw.predict(lw.read_arm(file, tip="tip"), recording)
        print(f"{name}: {said.rms_mm:.4f} mm RMS")
        figure.add_scatter(x=said.table["row"], y=said.table["residual_mm"], mode="markers", name=name)
