"""Tools that make HPN Select and assert nothing: benchmarks, mutants, texts, pictures, supply."""
