"""How the property tests draw examples: always the same ones; how many says tests/conftest.py."""

from hypothesis import HealthCheck, settings

bounded = settings(
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
few = settings(bounded, max_examples=max(2, bounded.max_examples * 2 // 5))
