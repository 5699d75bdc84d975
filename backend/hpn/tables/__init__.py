"""Tables: from text and workbooks to cells, numbers, headings and columns; no web library."""
