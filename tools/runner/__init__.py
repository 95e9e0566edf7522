"""Parts of tools/test.py: which tests run where, the programs and hosts that run them, and the two jobs at a time."""
