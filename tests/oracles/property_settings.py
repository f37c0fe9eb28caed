"""How many examples the property tests draw: always the same ones, without deadlines."""

from hypothesis import HealthCheck, settings

bounded = settings(
    max_examples=25,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
few = settings(bounded, max_examples=10)
