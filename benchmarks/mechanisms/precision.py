#!/usr/bin/python3
"""Error against CPU time of every integrator on every benchmark mechanism, through the program.

Errors are total errors (equation 3.2 of the thesis) against the built-in references. Prints, per mechanism, formulation and
integrator, the cheapest run that is at least as good as the thesis (OpenSim), and the cheapest that is ten times better.

usage: precision.py --sinew PATH [--accuracies 1e-3,1e-4,...] [--max-seconds 60] [--out results.json] [--figure FILE.png]
       precision.py --from results.json [--figure FILE.png]
"""
import argparse
import json
import subprocess
from pathlib import Path

MECHANISMS = {"A01": ["tree"], "A02": ["merged", "couplers", "loops"], "A03": ["tree"], "A04": ["end", "middle"], "A05": ["tree"]}
THESIS = {"A01": 3.6e-3, "A02": 9.8e-4, "A03": 4.7e-2, "A04": 6.4e-4, "A05": 7.3e-5}  # total error [%]
SLOW = {"couplers", "loops"}  # only where they can be compared: with the default integrator
DEFAULT = "rk_feldberg"  # of the slow formulations


def integrators(sinew):
    lines = subprocess.run([sinew, "list", "integrators"], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.split()[0] for line in lines[1:] if line.strip() and not line.startswith("What")]


def run(options, mechanism, formulation, integrator, accuracy):
    words = [options.sinew, "mbs", mechanism, "--integrator", integrator, "--accuracy", str(accuracy), "--formulation",
             formulation, "--max-seconds", str(options.max_seconds), "--json", "-"]
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)
    return json.loads(done.stdout)["runs"][0]


def study(options):
    runs = []
    for mechanism, formulations in MECHANISMS.items():
        for formulation in formulations:
            for integrator in integrators(options.sinew):
                if formulation in SLOW and integrator != DEFAULT:
                    continue
                for accuracy in options.accuracies:  # from rough to fine
                    one = run(options, mechanism, formulation, integrator, accuracy)
                    runs.append(one)
                    if one["failure"] and "of CPU time" in one["failure"]:
                        break  # finer only takes longer
    return runs


def cheapest(runs, limit):
    good = [r for r in runs if not r["failure"] and r["total_error_percent"] <= limit]
    return min(good, key=lambda r: r["cpu_seconds"]) if good else None


def cell(one):
    if one is None:
        return "-"
    return f"{one['cpu_seconds']:.3g} s ({one['accuracy']:.0e})"


def table(runs):
    rows = [["mechanism", "formulation", "integrator", "as good as the thesis", "ten times better", "best error %"]]
    keys = dict.fromkeys((r["mechanism"], r["formulation"], r["integrator"]) for r in runs)
    for key in keys:
        group = [r for r in runs if (r["mechanism"], r["formulation"], r["integrator"]) == key]
        errors = [r["total_error_percent"] for r in group if not r["failure"]]
        rows.append([*key, cell(cheapest(group, THESIS[key[0]])), cell(cheapest(group, THESIS[key[0]] / 10)),
                     f"{min(errors):.2g}" if errors else "-"])
    print("| " + " | ".join(rows[0]) + " |\n|" + "---|" * len(rows[0]))
    for row in rows[1:]:
        print("| " + " | ".join(row) + " |")


def draw(runs, file):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    names = list(dict.fromkeys(r["integrator"] for r in runs))
    figure, axes = pyplot.subplots(1, len(MECHANISMS), figsize=(15, 3.4), constrained_layout=True)
    for axis, mechanism in zip(axes, MECHANISMS):
        for formulation in MECHANISMS[mechanism]:
            for number, name in enumerate(names):
                group = [r for r in runs if r["mechanism"] == mechanism and r["formulation"] == formulation
                         and r["integrator"] == name and not r["failure"] and r["total_error_percent"] > 0]
                if not group:
                    continue
                first = formulation == MECHANISMS[mechanism][0]
                axis.plot([r["cpu_seconds"] for r in group], [r["total_error_percent"] for r in group], "o-" if first else "x--",
                          color=f"C{number}", markersize=3, linewidth=1, label=name if first else None)
        axis.axhline(THESIS[mechanism], color="0.5", linewidth=0.8)
        axis.text(0.98, THESIS[mechanism], "thesis", transform=axis.get_yaxis_transform(), ha="right", va="bottom", fontsize=7,
                  color="0.4")
        axis.set(xscale="log", yscale="log", title=mechanism, xlabel="CPU time [s]")
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("total error [%]")
    handles = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels())}
    figure.legend(handles.values(), handles.keys(), loc="lower center", ncol=len(handles),
                  fontsize=8, bbox_to_anchor=(0.5, -0.1))
    figure.savefig(file, bbox_inches="tight", dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", type=Path)
    parser.add_argument("--accuracies", type=lambda text: [float(w) for w in text.split(",")],
                        default=[10.0**-k for k in range(3, 12)])
    parser.add_argument("--max-seconds", type=float, default=60)
    parser.add_argument("--from", dest="earlier", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--figure", type=Path)
    options = parser.parse_args()
    runs = json.loads(options.earlier.read_text())["runs"] if options.earlier else study(options)
    if options.out:
        options.out.write_text(json.dumps({"schema": "sinew.precision/1", "runs": runs}, indent=1))
    table(runs)
    if options.figure:
        draw(runs, options.figure)


if __name__ == "__main__":
    main()
