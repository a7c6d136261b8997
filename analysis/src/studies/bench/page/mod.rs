//! The cost of the page of `haptic explore` in a browser of this machine.

pub mod scenes;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

use haptic_servo::number::Format;
use serde_json::{Value, json};

use self::scenes::PageScene;
use super::Rounds;
use super::figure::{Budget, Figure, Pair, median};
use crate::browser::{Page, Site};
use crate::file;
use crate::studies::error::StudyError;
use crate::verdict::judge_file;

/// Runs in the page before its own scripts.
const WATCH: &str = include_str!("watch.js");

/// Of a page's size.
const SIZE: Budget = Budget::of(700e3, "bytes");
/// Of the time from opening a page to its first visible verdict.
const OPENING: Budget = Budget::of(0.5, "s");
/// Of a verdict within a frame.
const VERDICT: Budget = Budget { value: 1.0, unit: "ms", source: "budget, of a frame" };
/// Of a frame.
const FRAME: Budget = Budget { value: 1e3 / 60.0, unit: "ms", source: "60 frames a second" };
/// Of a map of 40 000 points, and of the time until its first picture.
const MAP: Budget = Budget::of(1.0, "s");
const FIRST_PICTURE: Budget = Budget::of(100.0, "ms");
/// Of a verdict's time in a page over its time in this program.
const OVER_NATIVE: Budget = Budget::of(2.0, "times");

/// Width of the window in pixels.
const WIDTH: u32 = 1280;
/// Number of back-and-forth strokes of a drag.
const STROKES: f64 = 3.0;
/// Its reach to either side of the slider's middle, as a fraction of the slider's length.
const REACH: f64 = 0.3;

/// A page with its scene.
pub struct ScenePage {
    /// The scene.
    pub scene: PageScene,
    /// The page's text.
    pub text: String,
}

/// A browser that records the pages opened in it.
pub fn watching_browser() -> Result<Page, StudyError> {
    let mut browser = Page::start(WIDTH)?;
    browser.run_first(WATCH)?;
    Ok(browser)
}

/// All figures of the pages of scenes, the first of which is the page that `haptic explore` writes without a
/// file. Calls `progress` with the name of each measurement.
pub fn figures(
    mut browser: Page,
    pages: &[ScenePage],
    rounds: Rounds,
    progress: impl Fn(&str),
) -> Result<Vec<Figure>, StudyError> {
    let size = pages.first().map(|page| page.text.len() as f64);
    let size = size.map(|size| Figure::within("page of haptic explore: size", size, &SIZE));
    let mut figures: Vec<_> = size.into_iter().collect();
    for ScenePage { scene, text } in pages {
        let site = Site::of(text.clone())?;
        progress(&format!("opening the page, {}", scene.name));
        figures.extend(opened(&mut browser, &site, scene, rounds)?);
        progress(&format!("dragging {} on the page, {}", scene.dragged, scene.name));
        figures.extend(dragged(&mut browser, scene, rounds)?);
    }
    progress("judging in the page and here");
    figures.extend(compared(&mut browser, rounds)?);
    match browser.complaints.is_empty() {
        true => Ok(figures),
        false => Err(StudyError::Complaints(browser.complaints.clone())),
    }
}

/// Median and largest of some values, as two figures.
fn spread(name: &str, values: Vec<f64>, budget: &Budget) -> [Figure; 2] {
    let most = values.iter().copied().fold(0.0, f64::max);
    [("median", median(values)), ("most", most)]
        .map(|(which, value)| Figure::within(format!("{name}, {which}"), value, budget))
}

/// Opens the page several times: the times until its first verdict is visible, until the first picture of its
/// map, and until the whole map.
fn opened(
    browser: &mut Page,
    site: &Site,
    scene: &PageScene,
    rounds: Rounds,
) -> Result<Vec<Figure>, StudyError> {
    const PICTURE: &str = "document.querySelector('#picture-map')?.dataset";
    let [mut shown, mut first, mut all] = [const { Vec::new() }; 3];
    for _ in 0..rounds.openings {
        browser.go_to("about:blank")?;
        browser.go_to(&site.url())?;
        browser.wait_for("window.bench?.shown !== undefined")?;
        browser.wait_for(&format!("{PICTURE}?.progress === 'all'"))?;
        shown.push(browser.number("window.bench.shown")? / 1e3);
        first.push(browser.number(&format!("{PICTURE}.firstMs"))?);
        all.push(browser.number(&format!("{PICTURE}.allMs"))? / 1e3);
    }
    let measured = [
        ("opening to the first verdict on the screen", shown, OPENING),
        ("first picture of the map", first, FIRST_PICTURE),
        ("map of 40 000 points", all, MAP),
    ];
    let figures = measured.map(|(what, times, budget)| {
        spread(&format!("page, {}: {what}", scene.name), times, &budget)
    });
    Ok(figures.into_iter().flatten().collect())
}

/// Drags a slider of the open page with the mouse, back and forth.
fn dragged(
    browser: &mut Page,
    scene: &PageScene,
    rounds: Rounds,
) -> Result<Vec<Figure>, StudyError> {
    let movements = rounds.movements;
    let slider = format!("[data-key=\"{}\"] input[type=range]", scene.dragged);
    let [left, top, width, height] = browser.place(&slider)?;
    let at = |movement: usize| {
        let turn = TAU * STROKES * movement as f64 / movements as f64;
        [left + width * (0.5 + REACH * turn.sin()), top + height / 2.0]
    };
    browser.mouse("mousePressed", at(0))?;
    browser.value("window.bench.watch()")?;
    for movement in 1..=movements {
        browser.mouse("mouseMoved", at(movement))?;
    }
    let seen = "window.bench.seen";
    browser.value(&format!("{seen} = window.bench.watched()"))?;
    browser.mouse("mouseReleased", at(movements))?;
    let [frames, full, quick] = ["frames", "judge", "judge_without_remedies"]
        .map(|what| browser.numbers(&format!("{seen}.{what}")));
    let (frames, full, quick) = (frames?, full?, quick?);
    if full.is_empty() && quick.is_empty() {
        return Err(StudyError::NothingJudged { scene: scene.name, key: scene.dragged });
    }
    // If remedies take longer than a frame, they are computed when the hand rests.
    let measured = [
        ("verdict, words and remedies", full, VERDICT),
        ("verdict and words", quick, VERDICT),
        ("frame", frames, FRAME),
    ];
    let figures = measured.into_iter().filter(|(_, times, _)| !times.is_empty());
    let figures = figures.map(|(what, times, budget)| {
        spread(&format!("page, {}: {what} while a slider is dragged", scene.name), times, &budget)
    });
    Ok(figures.flatten().collect())
}

/// The times of the same verdicts in the open page and in this program, alternately, from a scene as JSON to
/// its verdict as JSON; the answers must be equal.
fn compared(browser: &mut Page, rounds: Rounds) -> Result<[Figure; 2], StudyError> {
    let questions: Vec<String> = scenes::judged().iter().map(Value::to_string).collect();
    browser.value(&format!("window.bench.start({})", json!(questions)))?;
    let answers = browser.value("window.bench.answers()")?;
    for (index, question) in questions.iter().enumerate() {
        let here = certify(question)?;
        let of_page = &answers[index];
        if *of_page != here.as_str() {
            let (question, of_page) = (question.clone(), of_page.clone());
            return Err(StudyError::OtherAnswer { question, of_page, here });
        }
    }
    browser.value(&format!("window.bench.round({})", rounds.warming))?;
    let microseconds = 1e3 / questions.len() as f64;
    let pair = Pair::in_turns(
        rounds.own,
        || Ok::<_, StudyError>(browser.number("window.bench.round(1)")? * microseconds),
        || Ok(round(&questions)? * microseconds),
    )?;
    let name = format!("page: verdict, {} scenes, median", questions.len());
    Ok([
        Figure::beside(name, pair, "us", "natively on one core"),
        Figure::within("page: verdict, WebAssembly over native", pair.ratio(), &OVER_NATIVE),
    ])
}

/// Time of all answers in this program in ms.
fn round(questions: &[String]) -> Result<f64, StudyError> {
    let start = Instant::now();
    for question in questions {
        black_box(certify(black_box(question))?);
    }
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

/// The work of the page's module for `certify`, with the same functions.
fn certify(question: &str) -> Result<String, StudyError> {
    let file = file::parse("scene", file::Format::Json, question)?;
    let report = judge_file(&file, Format::F64);
    Ok(serde_json::to_string(&report)?)
}
