"""What the owner of a bad rig file reads: which key, which value, which rule, how to mend it."""

from pathlib import Path

import pytest

from models.errors import InputError
from models.rig_file import read_rig

REFERENCE = Path(__file__).parents[1] / "data" / "reference_rig.toml"
OSCILLATOR_TOML = '[structure]\nkind = "oscillator"\nmass = 1.0\nstiffness = 2.0\ndamping = 0.1\n'


@pytest.fixture
def bad_rig(tmp_path):
    """Writes a rig file and answers with the message of reading it, less the file's name in front."""

    def complaint(content: str | bytes) -> str:
        path = tmp_path / "rig.toml"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(InputError) as caught:
            read_rig(path)
        assert str(caught.value).startswith("rig.toml: ")
        return str(caught.value).removeprefix("rig.toml: ")

    return complaint


# The reference rig with one text replaced, and what its owner reads; a message that ends in "..." goes on.

BAD_EDITS = [
    (
        "position = 1.0\nclearance = 1.5e-4",
        "position = 1.0\nclearance = -0.0002",
        "sleeves[1].clearance = -0.0002 m; a clearance is 0 or more; for a preload, use gap_offset",
    ),
    (
        "length = 1.469 ",
        "length = 0 ",
        "structure.length = 0 m; a length is above 0; measure from the clamp to the tip",
    ),
    (
        "length = 1.469 ",
        'length = "1.469" ',
        (
            'structure.length = "1.469"; length is a finite number in m; '
            "write a plain number, without quotes, nan or inf"
        ),
    ),
    ("length = 1.469 ", "length = true ", "structure.length = true; length is a finite number in m; ..."),
    ("length = 1.469 ", "length = nan ", "structure.length = nan m; length is a finite number in m; ..."),
    ("= 7850.0", "= -inf", "structure.density = -inf kg/m^3; density is a finite number in kg/m^3; ..."),
    ("= 7850.0", "= 1979-05-27", "structure.density = 1979-05-27; density is a finite number in kg/m^3; ..."),
    (
        "= 7850.0",
        f"= 1{'0' * 400}",
        f"structure.density = 1{'0' * 59}... kg/m^3; density is a finite number in kg/m^3; ...",
    ),
    (
        "density = 7850.0",
        "densty = 7850.0",
        (
            "structure.densty is unknown; the keys of [structure] are kind, length, diameter, youngs_modulus, "
            "density, rayleigh_damping, gravity; the nearest one is density"
        ),
    ),
    (
        "density = 7850.0",
        "",
        "structure.density is missing; a density is above 0; add density to [structure]",
    ),
    (
        "length = 1.469 ",
        "length = 1.469\nlength = 1.0 ",
        (
            "Cannot overwrite a value (at line 7, column 13); a rig file is valid TOML; correct that line; "
            "decimals take a point, texts stand in quotes, and a key stands once in its table"
        ),
    ),
    (
        "length = 1.469 ",
        "length = 1,469 ",
        "Expected newline or end of document after a statement (at line 6...",
    ),
    ("= 7850.0", f"= 1{'0' * 5000}", "Exceeds the limit (4300 digits)..."),
    ("= 7850.0", f"= {'[' * 3000}", "maximum recursion depth exceeded..."),
    (
        'kind = "beam"',
        'kind = "plate"',
        (
            'structure.kind = "plate"; a rig has one [structure] table, whose kind is "beam" or "oscillator"; '
            'write [structure] with kind = "beam" or kind = "oscillator"'
        ),
    ),
    ('kind = "beam"', "", "structure.kind is missing; a rig has one [structure] table, whose kind is..."),
    (
        "[structure]",
        "[structur]",
        (
            "structur is unknown; the keys of the rig file are structure, tolerances, sleeves, excitation, "
            "sensors, effects; the nearest one is structure"
        ),
    ),
    (
        "[1.2, 6e-6]",
        "1.2",
        (
            "structure.rayleigh_damping = 1.2; Rayleigh damping is a list of two numbers, eta1 in 1/s and eta2 in "
            "s; write it as in [1.2, 6e-6]"
        ),
    ),
    (
        "[1.2, 6e-6]",
        "[1.2]",
        "structure.rayleigh_damping[1] is missing; Rayleigh damping is a list of two...",
    ),
    (
        "[1.2, 6e-6]",
        "[1, 2, 3]",
        "structure.rayleigh_damping = [1, 2, 3]; Rayleigh damping is a list of two...",
    ),
    ("[1.2, 6e-6]", "[1.2, -1e-6]", "structure.rayleigh_damping[1] = -1e-06 s; eta2 is 0 or more; ..."),
    (
        "[1.2, 6e-6]",
        '["a", 1e-6]',
        'structure.rayleigh_damping[0] = "a"; rayleigh_damping is a finite number in 1/s...',
    ),
    (
        '"sleeves.clearance" = 0.03',
        "sleeves.clearance = 0.03",
        (
            "tolerances.sleeves = {...}; a tolerance is one standard deviation as a fraction of the value, "
            'above 0 and up to 1; for 3 % write "sleeves.clearance" = 0.03, a dotted key in quotes; '
            "leave out what is certain"
        ),
    ),
    (
        '"sleeves.clearance" = 0.03',
        '"sleeves.clearence" = 0.03',
        (
            'tolerances has the unknown key "sleeves.clearence"; the numbers of this rig that can have a '
            "tolerance are youngs_modulus, density, diameter, length, rayleigh_damping, sleeves.clearance, "
            'sleeves.stiffness, sleeves.damping; the nearest one is "sleeves.clearance"'
        ),
    ),
    (
        "youngs_modulus = 0.01",
        "youngs_modulus = 2",
        (
            "tolerances.youngs_modulus = 2; a tolerance is one standard deviation as a fraction of the value, "
            "above 0 and up to 1; for 3 % write youngs_modulus = 0.03; leave out what is certain"
        ),
    ),
    (
        'clearance" = 0.03',
        'clearance" = 3',
        (
            'tolerances."sleeves.clearance" = 3; a tolerance is one standard deviation as a fraction of the value, '
            'above 0 and up to 1; for 3 % write "sleeves.clearance" = 0.03; leave out what is certain'
        ),
    ),
    ('clearance" = 0.03', 'clearance" = nan', 'tolerances."sleeves.clearance" = nan; a tolerance is one...'),
    (
        'name = "sleeve 2"',
        'name = "sleeve 1"',
        (
            'sleeves[1].name = "sleeve 1", as sleeves[0].name; each name stands once in [[sleeves]]; '
            "give one of the two another name"
        ),
    ),
    ('name = "sleeve 2"', 'name = ""', 'sleeves[1].name = ""; a name is a printable text without blanks...'),
    ('name = "sleeve 2"', "name = 2", "sleeves[1].name = 2; a name is a printable text without blanks..."),
    (
        'name = "sleeve 2"\nposition = 1.0\nclearance = 1.5e-4',
        "clearance = -1",
        (
            "sleeves[1].name is missing; a name is a printable text without blanks around it; "
            "add name to [[sleeves]] (2 further problems in this file)"
        ),
    ),
    (
        "position = 1.0\nclearance",
        "position = 1.5\nclearance",
        (
            "sleeves[1].position = 1.5 m; a position lies within the beam, 0 to 1.469 m; "
            "measure from the clamp, in metres, or correct structure.length"
        ),
    ),
    (
        "position = 1.0\nclear",
        "position = 0\nclear",
        "sleeves[1].position = 0 m; a sleeve's position is above 0; ...",
    ),
    (
        "[excitation]",
        "[[excitation]]",
        "excitation = [{...}]; the excitation is one table; head it with [exc...",
    ),
    (
        'quantity = "force"',
        'quantity = "Force"',
        (
            'excitation.quantity = "Force"; an excitation\'s quantity is force, base_acceleration, base_velocity '
            "or base_displacement; choose one of these four"
        ),
    ),
    (
        'quantity = "force"',
        'quantity = "base_velocity"',
        (
            'excitation.position = 1.3 m beside quantity = "base_velocity"; a driven base moves clamp and '
            'sleeves together and has no position; remove position, or write quantity = "force"'
        ),
    ),
    ("position = 1.30", "", "excitation.position is missing; a force on a beam acts at a position; ..."),
    (
        "node = 100 ",
        "node = 100.0 ",
        "excitation.node = 100.0; a node is the whole number that the records...",
    ),
    (
        "node = 2",
        "node = 1",
        "sensors[1].node = 1, as sensors[0].node; each node stands once in [[sensors]]; ...",
    ),
    (
        "node = 2\nposition = 0.3",
        "node = 2",
        (
            "sensors[1].position is missing; a sensor on a beam has a position; "
            'add the distance of "P2" from the clamp, in metres'
        ),
    ),
    (
        "position = 0.3\n",
        "position = -0.3\n",
        "sensors[1].position = -0.3 m; a sensor's position is 0 or more; ...",
    ),
    (
        "node = 2\n",
        'node = 2\nsensitivity = "100 mV"\n',
        (
            'sensors[1].sensitivity = "100 mV"; a sensitivity is a number and a unit per unit; '
            'write it as in "100 mV/g", or leave it out where the records carry units'
        ),
    ),
    (
        "node = 2\n",
        'node = 2\nunit = "g"\n',
        "sensors[1].unit is unknown; the keys of [[sensors]] are name, ...",
    ),
]


@pytest.mark.parametrize(("old", "new", "expected"), BAD_EDITS, ids=[message[:50] for *_, message in BAD_EDITS])
def test_a_spoilt_reference_rig_says_what_how_and_where(bad_rig, old, new, expected):
    text = REFERENCE.read_text()
    assert old in text
    message = bad_rig(text.replace(old, new, 1))
    if expected.endswith("..."):
        assert message.startswith(expected.removesuffix("..."))
    else:
        assert message == expected


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ('sleeve = "sleeve 2"', "effects[0].kind is missing; an effect's kind is the name of an effect; add kind to"),
        (
            'kind = "wear"\nsleeve = "sleeve 3"',
            'effects[0].sleeve = "sleeve 3"; an effect\'s sleeve is one of this rig',
        ),
        (
            'kind = "sensor_gain"\nsensor = "P9"',
            "effects[0].sensor = \"P9\"; an effect's sensor is one of this rig's: P1,",
        ),
        (
            'kind = "point_mass"\nposition = 2.0',
            "effects[0].position = 2.0 m; a position lies within the beam, 0 to 1.469",
        ),
        ('kind = "wear"\nrate = inf', "effects[0].rate = inf; a setting is a finite number, a text, true or false, or"),
        ('kind = "x"\ntimes = [1.0, nan]', "effects[0].times = [1.0, nan]; a setting is a finite number, a text, true"),
        (
            'kind = "x"\ntable = {a = 1}',
            "effects[0].table = {...}; a setting is a finite number, a text, true or false",
        ),
    ],
)
def test_a_spoilt_effect_says_what_how_and_where(bad_rig, table, expected):
    assert bad_rig(f"{REFERENCE.read_text()}\n[[effects]]\n{table}\n").startswith(expected)


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (
            '[[sensors]]\nname = "x"\nposition = 0.1',
            "sensors[0].position = 0.1 m, on an oscillator; an oscillator has no",
        ),
        ("[excitation]\nposition = 0.1", "excitation.position = 0.1 m, on an oscillator; an oscillator has no length"),
        (
            '[tolerances]\n"sleeves.damping" = 0.1',
            'tolerances has the unknown key "sleeves.damping"; the numbers of this',
        ),
        (
            "length = 1.0",
            "structure.length is unknown; the keys of [structure] are kind, mass, stiffness, damping, grav",
        ),
        ("[sleeves]\nposition = 1.0", "sleeves = {...}; sleeves are a list of tables; head each one with [[sleeves]]"),
        (
            '[[sleeves]]\nname = "x"\nposition = 0.1\nclearance = 0.0\nstiffness = 1.0',
            'sleeves[0] is "x", on an oscillator; an oscillator has no sleeves; remove this table, or describe',
        ),
    ],
)
def test_a_spoilt_oscillator_says_what_how_and_where(bad_rig, more, expected):
    assert bad_rig(f"{OSCILLATOR_TOML}{more}\n").startswith(expected)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("", "structure is missing; a rig has one [structure] table, whose kind is"),
        (
            f"{OSCILLATOR_TOML}[sensors]\nname = 1\n[sensors]\nname = 2",
            "[sensors] in single brackets (Cannot declare",
        ),
        (f"{OSCILLATOR_TOML}[[sensor]]\nname = 1", "sensor is unknown; the keys of the rig file are structure"),
        ("structure = 5", "structure = 5; a rig has one [structure] table, whose kind is"),
        (f"effects = [5]\n{OSCILLATOR_TOML}", "effects[0] = 5; effects are a list of tables; head each one"),
        (b'[structure]\nkind = "b\xe4m"', "byte 22 is not UTF-8; a rig file is a text in UTF-8; save it"),
        ("hello = [", "Invalid value (at end of document); a rig file is valid TOML; see what was opened last and not"),
        (b"\x00", "Invalid statement (at line 1, column 1); a rig file is valid TOML; correct that line"),
    ],
)
def test_a_file_that_is_no_rig_says_what_it_is(bad_rig, content, expected):
    assert bad_rig(content).startswith(expected)


def test_lists_of_tables_are_named_by_their_heads(bad_rig):
    twice = bad_rig(f"{OSCILLATOR_TOML}[sensors]\nname = 1\n[sensors]\nname = 2")
    assert twice.endswith("are lists of tables, one for each; head each one with [[sensors]], in double brackets")
    assert bad_rig(f"{OSCILLATOR_TOML}[[sensor]]\nname = 1").endswith("the nearest one is [[sensors]]")


def test_two_misfits_are_told_as_one_problem_and_one_further(bad_rig):
    text = REFERENCE.read_text().replace("node = 2", "node = 1").replace("position = 1.44", "position = 14.4")
    message = bad_rig(text)
    assert message.startswith("sensors[7].position = 14.4 m; ")
    assert message.endswith(" (1 further problem in this file)")


@pytest.mark.parametrize(
    ("old", "new", "ending"),
    [
        ("youngs_modulus = ", "young_modulus = ", "the nearest one is youngs_modulus"),
        ("\nclearance = ", "\nclearence = ", "the nearest one is clearance (1 further problem in this file)"),
        ("youngs_modulus = ", "E = ", "take one of them, or remove it (1 further problem in this file)"),
        ("\ndensity = ", "\ndensitty = 1.0\n# ", "the nearest one is density"),
        ("\ndensity = ", "\ndensitty = 1.0\ndensity = ", "the nearest one is density"),
    ],
)
def test_a_misspelt_key_is_one_problem(bad_rig, old, new, ending):
    assert bad_rig(REFERENCE.read_text().replace(old, new)).endswith(f"; {ending}")
