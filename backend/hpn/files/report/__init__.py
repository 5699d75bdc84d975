"""PDF report."""
