"""The paper, reproduced: its Figures 2 to 6, the figure that it lacks, and what it says in numbers.

`figure_data` computes a figure, `reproduce` all of them into a folder; `statements` compares what
the paper says with what comes out. The command line is ``spectral-contact paper``.
"""

from spectral_contact.studies.paper.figures import FIGURES, figure_data, slip_onset
from spectral_contact.studies.paper.onset import SlipOnset
from spectral_contact.studies.paper.run import Reproduced, read_csv, reproduce
from spectral_contact.studies.paper.statements import Statement, statements
from spectral_contact.studies.paper.tables import PARAMETERS, FigureData, PaperFigure

__all__ = [
    "FIGURES",
    "PARAMETERS",
    "FigureData",
    "PaperFigure",
    "Reproduced",
    "SlipOnset",
    "Statement",
    "figure_data",
    "read_csv",
    "reproduce",
    "slip_onset",
    "statements",
]
