//! Filters as design tools print them: second-order sections, and zeros, poles and a gain, are the numerator
//! and denominator that an independent computation in rationals gives, and are certified.

use analysis::file::{self, FileError, Format, SceneFile};
use analysis::simulation::{Experiment, Integration};
use analysis::stability::{StabilityVerdict, judge};
use analysis::worst_hand::search;
use haptic_servo::certificate::{Rejection, certify};
use haptic_servo::environment::{Environment, Rational};

/// A Butterworth filter of order 8 at 0.02 of the Nyquist frequency, by SciPy 1.17: `butter(8, 0.02,
/// output="sos")` and `output="zpk"`.
const SECTIONS: &str = "type = \"sections\"\nsections = [
    [8.098259786747707e-13, 1.6196519573495413e-12, 8.098259786747707e-13, 1.0, -1.8802595219238372, 0.8839771204173436],
    [1.0, 2.0, 1.0, 1.0, -1.8970134052508192, 0.9007641290712767],
    [1.0, 2.0, 1.0, 1.0, -1.928769222871887, 0.9325827334397969],
    [1.0, 2.0, 1.0, 1.0, -1.971898055346293, 0.9757968390803613],
]\n";
const ZEROS_POLES_GAIN: &str = "type = \"zeros-poles-gain\"\ngain = 8.098259786747707e-13
zeros = [-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0]
poles = [[0.9859490276731465, 0.06083875336278829], [0.9643846114359435, 0.050448534818577785],
    [0.9485067026254096, 0.033153644534945015], [0.9401297609619186, 0.011539192823995577],
    [0.9401297609619186, -0.011539192823995577], [0.9485067026254096, -0.033153644534945015],
    [0.9643846114359435, -0.050448534818577785], [0.9859490276731465, -0.06083875336278829]]\n";

/// The product of the sections in rationals, each coefficient rounded once.
const NUMERATOR: [f64; 9] = [
    8.098259786747707e-13,
    6.478607829398165e-12,
    2.267512740289358e-11,
    4.535025480578716e-11,
    5.6687818507233944e-11,
    4.535025480578716e-11,
    2.267512740289358e-11,
    6.478607829398165e-12,
    8.098259786747707e-13,
];
const DENOMINATOR: [f64; 9] = [
    1.0,
    -7.6779402053928365,
    25.797219528171233,
    -49.54122563778754,
    59.47613197003972,
    -45.70873447791669,
    21.960120132116103,
    -6.03017223524432,
    0.724600926221652,
];

fn read(environment: &str) -> Result<SceneFile, FileError> {
    let text = format!(
        "name = \"filter\"\n[device]\ninertia = 1e-4\ndamping = 0.2\n[servo]\nperiod = 0.001\n\
         [environment]\n{environment}"
    );
    file::parse("filter.toml", Format::Toml, &text)
}

fn rational(environment: &str) -> Rational {
    match read(environment).unwrap_or_else(|error| panic!("{error}")).scene.environment {
        Environment::Rational(rational) => rational,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_filter_is_read_certified_and_judged() {
    let sections = rational(SECTIONS);
    assert_eq!(sections.numerator.as_slice(), NUMERATOR);
    assert_eq!(sections.denominator.as_slice(), DENOMINATOR);
    let by_roots = rational(ZEROS_POLES_GAIN);
    assert_eq!(by_roots.numerator.as_slice(), NUMERATOR);
    for (a, b) in by_roots.denominator.as_slice().iter().zip(DENOMINATOR) {
        assert!((a - b).abs() <= 4.0 * f64::EPSILON * b.abs(), "{a} {b}");
    }
    for environment in [SECTIONS, ZEROS_POLES_GAIN] {
        let file = read(environment).unwrap();
        assert_eq!(certify(&file.scene).map(|_| ()), Ok(()));
        let stability = judge(&Experiment::at_rest(&file), Integration::default()).unwrap();
        assert_eq!(stability.verdict, StabilityVerdict::Stable);
        assert!(!search(&file.scene, &file.chain).unwrap().oscillates);
        // The written form is the judged one.
        let written = file::write::toml(&file);
        let again = file::parse("again.toml", Format::Toml, &written).unwrap();
        assert_eq!(again.scene, file.scene);
        // A device with half of the index is rejected, and decided.
        let mut scene = file.scene;
        scene.device.damping = 0.04;
        assert!(matches!(
            certify(&scene),
            Err(Rejection::Shortage { .. } | Rejection::Coupling { .. })
        ));
    }
}

/// `butter(3, 0.1, "high", output="sos")`: three zeros at 1, which rounded coefficients would not sum to 0
/// for.
#[test]
fn zeros_at_one_stay_exact() {
    let high_pass = rational(
        "type = \"sections\"\ndelay = 1\nsections = [
            [0.7294407226390824, -0.7294407226390824, 0.0, 1.0, -0.726542528005361, 0.0],
            [1.0, -2.0, 1.0, 1.0, -1.647552215703991, 0.7323389172728038]]\n",
    );
    assert_eq!((high_pass.unit_zeros, high_pass.delay), (3, 1));
    assert_eq!(high_pass.numerator.as_slice(), [0.7294407226390824]);
    assert_eq!(high_pass.denominator.as_slice().len(), 4);
    let by_roots =
        rational("type = \"zeros-poles-gain\"\nzeros = [1, 1]\npoles = [0.5, [0.25]]\ngain = -2\n");
    assert_eq!((by_roots.unit_zeros, by_roots.numerator.as_slice()), (2, &[-2.0][..]));
    assert_eq!(by_roots.denominator.as_slice(), [1.0, -0.75, 0.125]);
}

#[test]
fn what_is_no_filter_is_refused_with_its_place_value_and_bound() {
    let row = "[1.0, 0.0, 0.0, 1.0, -0.5, 0.25]";
    let sections = |rows: &str| format!("type = \"sections\"\nsections = [{rows}]\n");
    let roots = |zeros: &str, poles: &str| {
        format!("type = \"zeros-poles-gain\"\nzeros = {zeros}\npoles = {poles}\ngain = 1\n")
    };
    let cases = [
        ("type = \"sections\"\n".to_owned(), "`environment.sections` is missing"),
        (sections("[1, 2, 3]"), "`environment.sections[0]`"),
        (sections("[1, 2, 3]"), "six finite numbers, [b0, b1, b2, a0, a1, a2]"),
        (sections("[1, 0, 0, 0, 1, 0]"), "has an a0 of 0"),
        (sections("[1, 0, 0, 1, nan, 0]"), "`environment.sections[0][4]`"),
        (sections(&[row; 5].join(", ")), "10 poles; there may be at most 8"),
        (sections("[1e300, 0, 0, 1e-300, 0, 0]"), "beyond the range of doubles"),
        (roots("[]", "[[0.5, 0.1]]"), "its conjugate is not in the list"),
        (roots("[]", "[[0.5, 0.1, 0.2]]"), "[real part, imaginary part]"),
        (roots("[]", "[[0.5, 0.1], [0.5, -0.2]]"), "its conjugate is not in the list"),
        (roots("0.5", "[0.5]"), "`environment.zeros`"),
        (format!("{}zeros = []\n", sections(row)), "`environment.zeros`"),
    ];
    for (environment, said) in cases {
        let error = read(&environment).expect_err(&environment).to_string();
        assert!(error.contains(said), "{said:?} is not in {error:?}");
    }
    let improper = read(&roots("[0.1, 0.2]", "[0.5]")).unwrap();
    assert_eq!(certify(&improper.scene).unwrap_err().reason(), "improper");
}
