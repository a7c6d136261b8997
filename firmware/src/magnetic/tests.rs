use super::*;
use crate::encoder_reading::EncoderReading;

fn frame(words: &[u16]) -> Frame {
    let mut frame = [0; LONGEST];
    frame[..words.len()].copy_from_slice(words);
    frame
}

/// A data line that has fallen or not.
struct Falls(bool);

impl Receiver for Falls {
    fn has_fallen(&self) -> bool {
        self.0
    }
}

/// Chip, words and angle.
const CASES: &[(&Chip, &[u16], u32)] = &[
    (&MT6701, &[0x0AAF, 0x0019], 0x2abc),
    // With its push button.
    (&MT6701, &[0x0AAF, 0x0115], 0x2abc),
    (&MT6701, &[0x0000, 0x010C], 0),
    (&MT6835, &[0xFFFF, 0xAAAA, 0xA804], 0x155555),
    (&MA702, &[0x1234], 0x1234),
    (&AS5048A, &[0x1235], 0x1235),
    (&AS5047P, &[0x1235], 0x1235),
];

/// Frames with checksums from another program.
#[test]
fn a_frame_has_its_angle() {
    for (chip, words, angle) in CASES {
        assert_eq!(chip.angle(&frame(words)), Ok(*angle), "{}", chip.name);
        let bits = u32::from(chip.interface.word_bits);
        let checked = if *chip.name == *"mt6835" { &[1, 2][..] } else { &[0, 1][..words.len()] };
        let has_check = !chip.name.starts_with("ma");
        for (&word, bit) in checked.iter().flat_map(|word| (0..bits).map(move |bit| (word, bit))) {
            let mut wrong = frame(words);
            wrong[word] ^= 1 << bit;
            assert_eq!(chip.angle(&wrong).is_err(), has_check, "{}, bit {bit}", chip.name);
        }
    }
}

#[test]
fn a_wire_that_is_broken_is_no_angle() {
    for chip in Chip::ALL {
        let ones = u16::MAX >> (16 - chip.interface.word_bits);
        assert_eq!(chip.angle(&[0; LONGEST]), Err(ReadingError::Zeros), "{}", chip.name);
        assert_eq!(chip.angle(&[ones; LONGEST]), Err(ReadingError::Ones), "{}", chip.name);
    }
}

/// The angle before takes the place of as many failed ones as are allowed, also again after a good one.
#[test]
fn a_failed_reading_is_an_older_one() {
    let mut readings = Readings::none();
    let word = |angle: u16| frame(&[angle | (angle.count_ones() as u16 % 2) << 15]);
    let mut take = |frame| match readings.take(&AS5048A, &frame, 2, Falls(false)) {
        Ok(()) | Err(Unread::Held) => Ok(readings.count() & 0x3FFF),
        fault => fault.map(|()| 0),
    };
    let lost = frame(&[u16::MAX]);
    assert_eq!(take(word(900)), Ok(900));
    assert_eq!([take(lost), take(lost)], [Ok(900); 2]);
    assert_eq!(take(word(950)), Ok(950));
    assert_eq!([take(lost), take(lost)], [Ok(950); 2]);
    assert_eq!([take(lost), take(lost)], [Err(Unread::Fault(ReadingError::Ones)); 2]);
    assert_eq!(take(word(960)), Ok(960));
}

#[test]
fn only_a_chip_that_is_never_quiet_can_be_told_to_be_frozen() {
    // Those which say that their noise is above a count.
    let never_rest = Chip::ALL.map(|chip| chip.frozen() > 0);
    assert_eq!(never_rest, Chip::ALL.map(|chip| *chip != MT6701));
    // A tick with a step is not told.
    let stops =
        |rests: &mut Rests, ticks: &[u32]| ticks.iter().position(|&tick| rests.take(tick, 3));
    let mut rests = Rests::default();
    assert_eq!(stops(&mut rests, &[3, 8, 9, 11, 12, 14, 16]), None);
    assert!(!rests.are(3));
    // Again as long as it stands still, and not after a step.
    assert_eq!(stops(&mut rests, &[18, 19, 20, 21, 22]), Some(4));
    assert!(rests.are(3) && rests.take(23, 3) && !rests.take(25, 3));
    rests.miss(2);
    assert_eq!(stops(&mut rests, &[28, 29, 30]), Some(2));
    // From any tick on, after 3 to 6 of them.
    for rested in 0..5_u32 {
        let mut rests = Rests::default();
        assert_eq!(
            stops(&mut rests, &(10..10 + rested).map(|at| 2 * at).collect::<Vec<_>>()),
            None
        );
        let found = stops(&mut rests, &[100, 101, 102, 103, 104, 105]);
        assert!(found.is_some_and(|last| (2..6).contains(&last)), "{rested}: {found:?}");
    }
}

#[test]
fn a_scene_states_an_age_that_covers_the_chip_s() {
    let check = |chip: &Chip, least: f64, most: f64| {
        let age = TimeRange::between(least, most);
        let encoder = EncoderReading { age, ..EncoderReading::IDEAL };
        let latency = Latency::NONE.read_by(Box::leak(Box::new(encoder)));
        let transfers = Transfers::at_count(chip, 1e-4);
        chip.check(&latency, &transfers, 16384.0)
            .map_err(|error| error.sentence().as_str().to_owned())
    };
    assert_eq!(check(&MT6701, 0.0, 1e-5), Ok(()));
    let error = check(&MT6701, 0.0, 9e-6).unwrap_err();
    assert!(error.contains("mt6701 have an age anywhere between 0 and 0.00001 s"), "{error}");
    assert!(check(&MT6701, 1e-6, 1e-5).is_err());
    // A period of 100 us more, less the 20 us in which the transfer before has ended and its wire has risen.
    assert_eq!(check(&AS5048A, 1.71e-4, 2.99e-4), Ok(()));
    assert!(check(&AS5048A, 9.1e-5, 1.99e-4).is_err());
    let error = check(&MA702, 0.0, 1e-4).unwrap_err();
    assert_eq!(error, "the encoder has 16384 counts in a turn, and ma702 has 65536");
}

/// By hand: 24 bits of an MT6701 at 170 MHz/32 take 4.518 us, beside the 5 us of a tick.
#[test]
fn a_phase_has_room_for_the_transfer() {
    let check = |delay: f64| {
        let age = TimeRange::between(0.0, 1e-5);
        let encoder = Box::leak(Box::new(EncoderReading { age, ..EncoderReading::IDEAL }));
        let latency = Latency::delayed(delay).read_by(encoder);
        MT6701.check(&latency, &Transfers::at_count(&MT6701, 1e-4), 16384.0)
    };
    assert_eq!([check(0.0), check(9.52e-6), check(9e-5)], [Ok(()); 3]);
    let Err(ChipError::Phase { shortest, .. }) = check(9.5e-6) else { panic!("it has room") };
    assert!((shortest - 9.518e-6).abs() < 1e-15, "{shortest}");
}

/// By hand: 24 bits of an MT6701 at 170 MHz/32 are 768 counts, and a us more are 938; an AS5048A was released
/// within a us before the update before, and saw that 10 us later at most.
#[test]
fn a_transfer_before_an_update_adds_to_the_age() {
    let near = |is: TimeRange, [least, most]: [f64; 2]| {
        assert!((is.least - least).abs() < 1e-12 && (is.most - most).abs() < 1e-12, "{is:?}");
    };
    let transfers = |chip| Transfers::before_update(chip, 2.5e-5, 170e6);
    assert_eq!(Transfers::lead_counts(&MT6701, 170e6), 939);
    near(MT6701.age_in(&transfers(&MT6701)), [768.0 / 170e6, 1e-5 + 939.0 / 170e6]);
    near(AS5048A.age_in(&transfers(&AS5048A)), [8.1e-5 + 2.5e-5, 1.99e-4 + 2.5e-5 + 171.0 / 170e6]);
    // What the scene states beyond that: 25.6 us are one update, and a dropped reading 40 of them.
    for (most, dropped, may) in [(1.56e-5, 0, 0), (4.12e-5, 0, 1), (4.12e-5, 1, 41)] {
        let age = TimeRange::between(0.0, most);
        let encoder = EncoderReading { age, dropped, ..EncoderReading::IDEAL };
        assert_eq!(transfers(&MT6701).may_fail(&MT6701, &encoder, 1e-3), may);
    }
}

/// Words whose first is zero: one less, only zeros have a status that they have not.
#[test]
fn no_status_of_an_mt6835_is_hidden_by_zeros() {
    let of = |content| MT6835.checksum.map(|checksum| u32::from(checksum.of(content)));
    for second in 0..=u16::MAX {
        let angle = MT6835.angle(&[0, 0, second]);
        let [content, checksum] = [second >> 8, second & 0xFF].map(u32::from);
        let is_angle = content & 0b111 == 0 && of(content) == Some(checksum);
        assert_eq!(angle.is_ok(), is_angle && second != 0, "{second:#06x}");
    }
}

/// A handle may rest where all bits are equal. A line at ground does not fall, and an open line is told elsewhere.
#[test]
fn a_word_of_equal_bits_may_be_an_angle() {
    let takes = |chip: &Chip, first: &[u16], word: u16, has_fallen| {
        let mut readings = Readings::none();
        let _ = readings.take(chip, &frame(first), 0, Falls(false));
        let taken = readings.take(chip, &frame(&[word]), 0, Falls(has_fallen));
        taken.map(|_| readings.count())
    };
    const ZEROS: Result<u32, Unread> = Err(Unread::Fault(ReadingError::Zeros));
    const ONES: Result<u32, Unread> = Err(Unread::Fault(ReadingError::Ones));
    for (chip, near, far) in [
        (&MA702, &[200][..], &[300][..]),
        (&AS5048A, &[3], &[0x8400]),
        (&MT6701, &[0x0000, 0x010C], &[0x0AAF, 0x0019]),
        (&MT6835, &[0xFFFF, 0, 0x0838], &[0xFFFF, 0xAAAA, 0xA804]),
    ] {
        assert!(chip.angle(&frame(near)).is_ok() && chip.angle(&frame(far)).is_ok());
        // Also as the first reading.
        for before in [near, far, &[0]] {
            assert_eq!(takes(chip, before, 0, true), Ok(0), "{}", chip.name);
            assert_eq!(takes(chip, before, 0, false), ZEROS, "{}", chip.name);
        }
    }
    assert_eq!(takes(&MA702, &[65_400], 65_535, false), Ok(65_535));
    assert_eq!(takes(&MA702, &[65_000], 65_535, true), ONES);
    assert_eq!(takes(&MA702, &[0], 65_535, true), ONES);
    assert_eq!(takes(&AS5048A, &[3], 65_535, true), ONES);
}
