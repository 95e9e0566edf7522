"""The sample scenes, one module for each family."""
