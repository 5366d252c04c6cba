"""Runs every benchmark, one after the other: about an hour on the machine of BENCHMARK.md.

    python -m benchmarks

The data is expected in ../shared/data beside the repository. A benchmark that lacks its data or Open3D fails,
and the others go on. The pictures in docs/images stay: `python benchmarks/fall_off.py` draws them anew.
`python benchmarks/side_by_side.py` is not among them: it compares with another checkout.
"""

import subprocess
import sys
from pathlib import Path

COMMANDS = (
    "segment_accuracy.py",
    "segment_accuracy.py --simulated 0 1 2",
    "real_crops.py",
    "hidden_sensor.py",
    "rigid_motion.py",
    "speed.py",
    "fpfh_agreement.py",
    "growth.py",
    "discrimination.py",
    "baselines.py",
    "rivals.py",
    "stimuli_ablation.py --repeats 2",
    "concept_quality.py",
    "concept_ablation.py",
    "concept_growth.py",
    "concept_numbers.py",
    "hidden_parts.py",
    "foreign_segments.py",
    "tree_responses.py",
    "mesh_views.py",
    "concept_cuts.py",
    "noise.py",
    "dip_table.py",
    "novelty.py",
    "motif_rigid_motion.py",
    "motif_speed.py",
    "spanning_tree.py --large --scipy",
    "filtration_growth.py",
    "labelling.py",
    "explore_kills.py",
    "extraction.py osd",
    "extraction.py simulated --seed 800",
    "extraction.py time",
    "extraction.py learn",
    "jobs.py",
    "learn.py",
    "report.py",
    "small_files.py",
    "recordings.py",
    "start.py",
    "kills.py",
    "other_processor.py",
)


def main() -> None:
    folder = Path(__file__).resolve().parent
    failed = []
    for command in COMMANDS:
        print(f"\n== benchmarks/{command}", flush=True)
        script, *arguments = command.split()
        if subprocess.run([sys.executable, str(folder / script), *arguments]).returncode != 0:
            failed.append(command)
    if failed:
        sys.exit(f"\nfailed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
