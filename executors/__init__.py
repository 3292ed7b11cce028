"""Where long work is done: in this process, in processes of this machine, or by the workers of a dask cluster."""

from linkwright.core.executors.cluster import Cluster
from linkwright.core.executors.executor import Executor, Here, Work, WorkersLost, plain
from linkwright.core.executors.processes import Processes

__all__ = ["Cluster", "Executor", "Here", "Processes", "Work", "WorkersLost", "plain"]
