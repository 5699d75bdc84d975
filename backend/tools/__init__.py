"""What helps to make HPN Select and asserts nothing: benchmarks, mutants, texts, pictures, supply."""
