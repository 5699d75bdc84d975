"""Documents, the saved content. A machine has a title block, common values and axes; a selection has one axis.

- `common`: `Common`, the values that hold for every axis, and COMMON, the paths of fields that may be among them
- `axis`: `Axis`, one axis as it is sent, with its own values and `without`; the bounds of a document
- `document`: `Document`, a machine as it is sent, and `TitleBlock`
- `merge`: `resolve(own, common, without)`, the application of an axis, or the faults that leave it open
- `answers`: `answers(axes, catalogue)`, the `AxisAnswer` of many axes in one evaluation
- `revision`: labels of revisions, and `Frozen`, the complete document of a revision, in packed bytes
- `gears`: the list of gears to order, with quantities and masses
- `summary`: `summary_of(document, catalogue)`, a document in brief
- `differences`: `differences(one, other)` of two documents axis by axis, and `today(document, catalogue)`
- `kinds`: `kinds_of(axes, catalogue)`, the mass with fewer kinds of gears, and the axes that change

Nothing here knows the store or the web. `hpn.store` keeps documents as rows (`records.py`), and `hpn.web.columns` turns
axes and answers into its columns and back.
"""
