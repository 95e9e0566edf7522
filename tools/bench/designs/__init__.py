"""Published reconstructions, written for reading, that the product's own is compared with (docs/benchmark/designs.md)."""
