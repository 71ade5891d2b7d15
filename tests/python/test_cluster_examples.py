# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests what examples give to Slurm and Kubernetes, by dask-jobqueue and dask-kubernetes."""

import json
import subprocess
from pathlib import Path

import pytest
from waiting import HANG, package_folder

ROOT = Path(__file__).resolve().parents[2]
# scripts/setup --tests installs both libraries there.
PYTHON = ROOT / "build" / "tools-venv" / "bin" / "python"


def shown(name, library, *options):
    """Returns what an example prints with --show."""
    command = {"text": True, "capture_output": True, "timeout": HANG}
    variables = {"PYTHONPATH": str(package_folder()), "PATH": "/usr/bin:/bin"}
    if not PYTHON.exists() or subprocess.run([PYTHON, "-c", f"import {library}"]).returncode:
        pytest.skip(f"{library} is not installed; run scripts/setup --tests")
    script = ROOT / "examples" / name
    done = subprocess.run(
        [PYTHON, script, "head.nii.gz", "--show", *options], env=variables, **command
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_job_of_slurm_has_one_worker_with_all_its_processors():
    script = shown("bake_on_slurm.py", "dask_jobqueue", "--queue", "night", "--cores", "6")
    subprocess.run(["bash", "-n"], input=script, text=True, check=True)
    asked = [line for line in script.splitlines() if line.startswith("#SBATCH")]
    for option in ("-p night", "-n 1", "--cpus-per-task=6", "--mem=15G", "-t 04:00:00"):
        assert f"#SBATCH {option}" in asked
    (worker,) = [line for line in script.splitlines() if "dask_worker" in line]
    assert "--nthreads 1" in worker and "tcp://" in worker and "--nworkers" not in worker


def test_a_cluster_of_kubernetes_has_workers_with_one_thread_for_dask():
    options = ("--image", "registry/leaflight", "--workers", "3", "--memory", "2Gi")
    text = shown("bake_on_kubernetes.py", "dask_kubernetes", *options)
    cluster = json.loads(text)
    assert cluster["kind"] == "DaskCluster" and cluster["metadata"]["name"] == "leaflight"
    workers = cluster["spec"]["worker"]
    (container,) = workers["spec"]["containers"]
    assert workers["replicas"] == 3 and container["image"] == "registry/leaflight"
    assert container["args"][:4] == ["dask", "worker", "--nthreads", "1"]
    for kind in ("requests", "limits"):
        assert container["resources"][kind] == {"cpu": "8", "memory": "2Gi"}
