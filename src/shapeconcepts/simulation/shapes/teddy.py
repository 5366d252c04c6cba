"""Teddy bears, sitting, standing or lying on the back."""

from __future__ import annotations

import numpy as np

from shapeconcepts.simulation.shapes.deformation import crumpled
from shapeconcepts.simulation.shapes.mesh import Mesh, ellipsoid, join, limb, mirrored, moved, rotated

PARTS = (
    "body",
    "head",
    "muzzle",
    "left ear",
    "right ear",
    "left arm",
    "right arm",
    "left leg",
    "right leg",
)
BODY, HEAD, MUZZLE, LEFT_EAR, RIGHT_EAR, LEFT_ARM, RIGHT_ARM, LEFT_LEG, RIGHT_LEG = range(9)


def make_teddy(rng: np.random.Generator) -> Mesh:
    """A bear 18 to 42 cm long, facing -y, with its own proportions and posture."""
    sitting = rng.random() < 0.65
    girth = rng.uniform(0.9, 1.15)
    hip = 0.09 if sitting else 0.34
    torso_half = np.array([0.19 * girth, 0.165 * girth, 0.25])
    torso_middle = hip + 0.17
    torso = ellipsoid(torso_half, (0.0, 0.0, torso_middle), label=BODY)
    arms = [_arm(rng, torso_middle, girth, side) for side in (-1.0, 1.0)]
    legs = [_leg(rng, hip, girth, sitting, side) for side in (-1.0, 1.0)]
    head = _head(rng, rng.uniform(0.9, 1.15))
    head = moved(head, (0.0, -0.01, torso_middle + 0.33))
    mesh = join([torso, *arms, *legs, head])
    mesh = mesh._replace(vertices=rng.uniform(0.25, 0.48) * mesh.vertices)
    mesh = crumpled(mesh, rng, amplitude=rng.uniform(0.001, 0.003), wavelength=0.025)
    return rotated(mesh, 0, -np.pi / 2.0) if rng.random() < 0.15 else mesh


def _arm(rng: np.random.Generator, torso_middle: float, girth: float, side: float) -> Mesh:
    shoulder = np.array([0.13 * girth, -0.01, torso_middle + 0.15])
    spread, forward, lift = rng.uniform(0.14, 0.26), rng.uniform(0.02, 0.2), rng.uniform(-0.22, 0.12)
    hand = shoulder + np.array([spread, -forward, lift])
    elbow = (shoulder + hand) / 2.0 + (0.05, 0.02, 0.0)
    arm = limb(shoulder, elbow, hand, 0.07, 0.065, LEFT_ARM)
    return arm if side > 0 else mirrored(arm, RIGHT_ARM)


def _leg(rng: np.random.Generator, hip: float, girth: float, sitting: bool, side: float) -> Mesh:
    joint = np.array([0.1 * girth, -0.03, hip])
    if sitting:
        stride = rng.uniform([0.04, -0.36, -0.02], [0.16, -0.26, 0.02])
        toes = (0.0, -0.02, 0.055)
    else:
        stride = rng.uniform([0.0, -0.06, -0.28], [0.06, 0.03, -0.28])
        toes = (0.0, -0.045, 0.02)
    foot = joint + stride
    thigh = limb(joint, (joint + foot) / 2.0 + (0.02, 0.0, 0.02), foot, 0.09 * girth, 0.08, LEFT_LEG)
    sole = ellipsoid((0.075, 0.055, 0.1) if sitting else (0.075, 0.11, 0.06), foot + toes, label=LEFT_LEG)
    leg = join([thigh, sole])
    return leg if side > 0 else mirrored(leg, RIGHT_LEG)


def _head(rng: np.random.Generator, size: float) -> Mesh:
    skull = ellipsoid((0.185, 0.165, 0.165), label=HEAD)
    snout = rng.uniform(0.055, 0.085)
    muzzle = ellipsoid((0.09, snout, 0.07), (0.0, -0.135, -0.045), label=MUZZLE, n=20)
    nose = ellipsoid((0.028, 0.018, 0.02), (0.0, -0.135 - 0.9 * snout, -0.02), label=MUZZLE, n=10)
    ear_size = rng.uniform(0.055, 0.08)
    ear = ellipsoid((ear_size, 0.042, ear_size), (0.135, 0.0, 0.145), label=LEFT_EAR, n=20)
    head = join([skull, muzzle, nose, ear, mirrored(ear, RIGHT_EAR)])
    head = head._replace(vertices=size * head.vertices)
    head = rotated(head, 1, np.radians(rng.uniform(-15.0, 15.0)))
    head = rotated(head, 0, np.radians(rng.uniform(-10.0, 20.0)))
    return rotated(head, 2, np.radians(rng.uniform(-35.0, 35.0)))
