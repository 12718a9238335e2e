"""The benchmarks that others rely on by name give rates, and their table has rows. Usage: bench.py GLISS_BENCH BENCH_TABLE"""
import json
import pathlib
import subprocess
import sys
import tempfile

bench, table = sys.argv[1:]
names = [f"{path}/exact/{precision}/4/tbb/1" for precision in ("float", "double")
         for path in ("evaluate", "evaluate_irregular", "evaluate_shuffled", "build", "build_checked", "track",
                      "nearest", "nearest_spatial", "tick", "sweep", "load", "api_evaluate", "api_evaluate_irregular",
                      "api_grid", "api_evaluate_shuffled", "api_nearest", "api_track")]
names += [f"evaluate/exact/float/{n}/tbb/{threads}" for n in (3, 4, 5, 6) for threads in (1, 2)]
names += [f"machine/{what}/1" for what in ("fma/float", "fma/double", "read", "write", "triad")]
peers = {"opensubdiv": ["evaluate_irregular/1", "evaluate_regular/1"],
         "embree": ["evaluate_irregular/1", "evaluate_regular/1", "nearest_46080/1"]}

listed = subprocess.run([bench, "--benchmark_list_tests"], capture_output=True, text=True, check=True).stdout.split()
for peer, of in peers.items():
    if any(name.startswith(f"peer/{peer}/") for name in listed):  # else it is not installed
        names += [f"peer/{peer}/{name}" for name in of]
missing = sorted(set(names) - set(listed))
assert not missing, f"not there: {missing}"

with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder, "bench.json")
    subprocess.run([bench, "--size=240", f"--benchmark_filter=^({'|'.join(names)})$", "--benchmark_min_time=0.001",
                    f"--benchmark_out={out}", "--benchmark_out_format=json"], check=True)
    results = {b["name"]: b for b in json.loads(out.read_text(encoding="utf-8"))["benchmarks"]}
    file = pathlib.Path(folder, "RESULTS.md")
    file.write_text("before\n<!-- bench: begin -->\nold\n<!-- bench: end -->\nafter\n", encoding="utf-8")
    subprocess.run([sys.executable, table, out, file], check=True)
    text = file.read_text(encoding="utf-8")
for name in names:
    assert results[name]["items_per_second"] > 0, f"{name}: {results[name]}"
exact = results["evaluate/exact/float/4/tbb/1"]
assert exact["flops"] > 1000 and exact["of_peak"] > 0, exact
for name in names:
    assert not name.startswith("api_") or results[name]["of_kernel"] > 0, f"{name}: {results[name]}"
assert results["track/exact/double/4/tbb/1"]["error_p999"] < 1e-6, results["track/exact/double/4/tbb/1"]
assert text.startswith("before\n") and text.endswith("after\n") and "\nold\n" not in text, text
assert "| evaluate/exact/float/4/tbb/1 |" in text, text
