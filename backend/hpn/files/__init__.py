"""Files of a selection: PDF report, workbook with live formulas, Asset Administration Shell."""
