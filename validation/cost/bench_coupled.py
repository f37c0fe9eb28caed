"""Time solves with elastic coupling, as `bench_solve` does those without.

Run as ``python validation/cost/bench_coupled.py``; writes validation/results/bench_coupled.md.
"""

from bench_solve import COUPLED, run

if __name__ == "__main__":
    run("bench_coupled", COUPLED)
