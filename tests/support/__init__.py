"""Helpers of the tests that run in a host."""
