"""What several tests share: oracles, cases, faults."""
