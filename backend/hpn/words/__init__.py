"""Words: names of quantities, their units and symbols, and their form in each language."""
