"""What leaves the service as a file: PDF report, workbook with live formulas, Asset Administration Shell."""
