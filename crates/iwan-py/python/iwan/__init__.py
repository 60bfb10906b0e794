"""Ring-down of bolted structures with Iwan friction models: simulate and identify.

>>> import iwan
>>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
>>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4)
>>> blow = iwan.Haversine(amplitude=1000.0, duration=1.6e-3)
>>> response = iwan.simulate(mode, force=blow, dt=1e-5, duration=0.2)
>>> len(response.t)
20001

Units are your own consistent set; frequencies in Hz, times in s, damping as a ratio (0.01 = 1 %). Method: Deaner, Allen,
Starr, Segalman, *Investigation of Modal Iwan Models for Structures with Bolted Joints*; equation numbers are the paper's.
"""

from iwan import ensemble, plot
from iwan._native import (
    Coulomb,
    Envelope,
    FiveParameter,
    FourParameter,
    HalfSine,
    Haversine,
    Jenkins,
    Joint,
    Mode,
    ModeCurves,
    Part,
    Pinning,
    PowerDamping,
    Pulse,
    Record,
    Response,
    Sampled,
    Sine,
    Spring,
    Step,
    Tabulated,
    Uniform,
    __version__,
    envelope,
    read_record,
    simulate,
    superpose,
)
from iwan.coupled import CoupledModes, CoupledResponse, JointHistory, SharedJoint
from iwan.identification import Fit, fit
from iwan.likelihood import LogLikelihood, log_likelihood
from iwan.errors import (
    ComputationError,
    ExistingFileError,
    FileError,
    IdentificationError,
    InvalidTypeError,
    InvalidValueError,
    IwanError,
    MissingFileError,
    RecordError,
    StructureError,
)

from iwan.modal import ModalFit, ModalMode, modal_fit
from iwan.records import as_record
from iwan.steady import Backbone, SteadyResponse, backbone, frf
from iwan.structure import StaticCurves, Structure, StructureModes, StructureResponse
from iwan.study import reproduce
from iwan.sweeps import SweepFit
from iwan.updating import ComparedBlow, ComparedCurve, Estimate, StructureUpdate, UpdatedJoints, update
from iwan.coupled_fit import CoupledFit, fit_coupled

__all__ = [
    "Backbone",
    "ComparedBlow",
    "ComparedCurve",
    "ComputationError",
    "Coulomb",
    "CoupledFit",
    "CoupledModes",
    "CoupledResponse",
    "Envelope",
    "Estimate",
    "ExistingFileError",
    "FileError",
    "Fit",
    "FiveParameter",
    "FourParameter",
    "HalfSine",
    "Haversine",
    "IdentificationError",
    "InvalidTypeError",
    "InvalidValueError",
    "IwanError",
    "Jenkins",
    "Joint",
    "JointHistory",
    "LogLikelihood",
    "MissingFileError",
    "ModalFit",
    "ModalMode",
    "Mode",
    "ModeCurves",
    "Part",
    "Pinning",
    "PowerDamping",
    "Pulse",
    "Record",
    "RecordError",
    "Response",
    "Sampled",
    "SharedJoint",
    "Sine",
    "Spring",
    "StaticCurves",
    "SteadyResponse",
    "Step",
    "Structure",
    "StructureError",
    "StructureModes",
    "StructureResponse",
    "StructureUpdate",
    "SweepFit",
    "Tabulated",
    "Uniform",
    "UpdatedJoints",
    "__version__",
    "as_record",
    "backbone",
    "ensemble",
    "envelope",
    "fit",
    "fit_coupled",
    "frf",
    "log_likelihood",
    "modal_fit",
    "plot",
    "read_record",
    "reproduce",
    "simulate",
    "superpose",
    "update",
]
