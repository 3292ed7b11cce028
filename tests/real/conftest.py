"""Recordings of real machines: their tests are skipped, with the reason, where the recordings are not there."""

import pytest

from benchmarks.real.data import NoDataError, recording_file

NEEDED = {
    "test_motoman": [
        ("motoman-ma2010", f"{kind}_test{day}_R1.csv") for kind in ("grid", "line") for day in ("0516", "0801")
    ],
    "test_ur10": [("ur10", "series_A.csv"), ("ur10", "series_B.csv")],
    "test_iiwa7": [("iiwa7-payloads", name) for name in ("run1_0kg.csv", "run2_1.25kg.csv", "run3_2.5kg.csv")],
    "test_irb120": [("irb120-faro", "recording_both_angles.csv")],
    "test_servo": [("sts3215-backlash", "motor_telemetry_single.csv")],
    "test_printer": [
        ("voron-thermal", "frame_exp_quant_v3_2021-06-12_12-54-36-mvieleers_V2.1253.csv"),
        ("voron-thermal", "frame_exp_quant_v3_2021-06-13_05-41-53.csv"),
    ],
}


@pytest.fixture(autouse=True)
def _there(request: pytest.FixtureRequest) -> None:
    try:
        for machine, name in NEEDED.get(request.module.__name__.rpartition(".")[2], []):
            recording_file(machine, name)
    except NoDataError as missing:
        pytest.skip(str(missing))
