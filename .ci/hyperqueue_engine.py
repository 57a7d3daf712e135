"""The engine HyperQueue by its Python package, which has the server and the workers but not the program `hq`.

    python hyperqueue_engine.py serve DIR WORKERS     a server and workers of one core each, until it is killed
    hq --output-mode quiet job submit-file job.toml   as a program named `hq`: submits tasks, prints the job's number
    hq wait JOB                                       waits; exit code 1 where a task failed

`hq` finds the server in $HQ_SERVER_DIR. Tasks of a job file are submitted by the package's own client; of their keys it has no time limit.
"""

import os
import sys
import time
import tomllib

from hyperqueue import Client, Job, LocalCluster
from hyperqueue.cluster import WorkerConfig
from hyperqueue.ffi.protocol import ResourceRequest


def serve(directory: str, workers: str) -> None:
    with LocalCluster(directory) as cluster:
        for _ in range(int(workers)):
            cluster.start_worker(WorkerConfig(cores=1))
        print("ready", flush=True)
        while True:
            time.sleep(3600)


def submit(path: str) -> None:
    with open(path, "rb") as file:
        described = tomllib.load(file)
    # One failed task does not end the others, as with the program.
    job = Job(max_fails=None, name=described.get("name"))
    tasks = {}
    for task in described["task"]:
        request = task["request"][0]["resources"]
        unknown = set(task) - {"id", "command", "cwd", "stdout", "stderr", "time_limit", "deps", "env", "request"}
        if unknown:
            sys.exit(f"{path}: keys that are not known here: {unknown}")
        tasks[task["id"]] = job.program(
            task["command"],
            cwd=task["cwd"],
            stdout=task["stdout"].replace("%{JOB_ID}", "job"),
            stderr=task["stderr"].replace("%{JOB_ID}", "job"),
            deps=[tasks[id] for id in task.get("deps", [])],
            env=task.get("env"),
            resources=ResourceRequest(cpus=request["cpus"]),
        )
    print(Client(os.environ["HQ_SERVER_DIR"]).submit(job).id)


def wait(job: str) -> None:
    failed = Client(os.environ["HQ_SERVER_DIR"]).connection.wait_for_jobs([int(job)], lambda _: None)
    sys.exit(1 if failed else 0)


match sys.argv[1:]:
    case ["serve", directory, workers]:
        serve(directory, workers)
    case ["--output-mode", "quiet", "job", "submit-file", path]:
        submit(path)
    case ["wait", job]:
        wait(job)
    case other:
        sys.exit(f"not known here: {other}")
