"""mbk: the mechanical impedance of the human arm, measured with a robot.

>>> import mbk
>>> recording = mbk.simulate("relaxed_sinusoidal")
>>> result = mbk.measure(recording)
>>> result.model.K.shape, result.unit("model.K")
((2, 2), 'N/m')
>>> result.usable
True

Each command of the program is a function with the same options (`_` for `-`; `from_` for `--from`). It returns an object
whose `.to_dict()` is the JSON document of the command. Force F is the force of the hand on the robot:
M ẍ + B ẋ + K (x − x₀) = −F. Units are SI and radians.
"""

from __future__ import annotations

from mbk import _interpreter

_interpreter.refuse_sub_interpreter()

from mbk import _mbk, robot, sensor, springs, study
from mbk._documents import (
    Comparison,
    Document,
    Ellipses,
    Exploration,
    Information,
    Movement,
    Part,
    Passivity,
    Result,
    Results,
    RobotDynamics,
    Springs,
    StudyList,
    StudySummary,
    Teleoperation,
    TransferFunction,
    Validation,
    VirtualForce,
    load,
)
from mbk._errors import DataError, Error, MbkWarning, NotUsableError, UsageError
from mbk._functions import (
    compare,
    convert,
    ellipse,
    explore,
    identify,
    info,
    measure,
    movement,
    passivity,
    read,
    recover,
    reproduce,
    simulate,
    teleop,
    transfer_function,
    validate,
)
from mbk._live import Live, live
from mbk._recording import Recording

__version__: str = _mbk.__version__
tf = transfer_function  # name of the command

__all__ = [
    "Comparison", "DataError", "Document", "Ellipses", "Error", "Exploration", "Information", "Live", "MbkWarning",
    "Movement", "NotUsableError", "Part", "Passivity", "Recording", "Result", "Results", "RobotDynamics", "Springs",
    "StudyList", "StudySummary", "Teleoperation", "TransferFunction", "UsageError", "Validation", "VirtualForce",
    "compare", "convert", "ellipse", "explore", "identify", "info", "live", "load", "measure", "movement", "passivity",
    "read", "recover", "reproduce", "robot", "sensor", "simulate", "springs", "study", "teleop", "tf", "transfer_function", "validate",
]
