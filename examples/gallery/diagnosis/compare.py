"""Before and after a repair: what changed beyond chance, by one model of both recordings."""

import linkwright as lw

folder = "examples/hidden-backlash"
change = lw.compare(f"{folder}/arm.yaml", f"{folder}/recording.csv", f"{folder}/after-service.csv")
print(change)
figure = change.plot()
