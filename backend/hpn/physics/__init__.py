"""Physics: the printed formulas and the mechanics of mechanisms, on arrays."""
