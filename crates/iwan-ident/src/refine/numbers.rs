//! The records of a search as a row of numbers, from which another process makes them again with the same bits.

use nalgebra::{DMatrix, DVector};
use rustfft::num_complex::Complex64;

use super::amplitudes::whitening::Whitening;
use super::amplitudes::windows::Windows;
use super::discount::Discount;
use super::record::{Noise, Windowed};
use super::release::TurningPoint;
use super::ring_down::Discrepancy;
use super::task::Task;
use crate::curves::Quantity;
use crate::parameters::Parameter;
use crate::search::Chart;

/// Numbers one after another; lists begin with their length.
#[derive(Debug, Default)]
pub(crate) struct Numbers(pub(crate) Vec<f64>);

impl Numbers {
    fn flag(&mut self, flag: bool) {
        self.0.push(f64::from(u8::from(flag)));
    }

    fn count(&mut self, count: usize) {
        self.0.push(count as f64);
    }

    fn list(&mut self, list: &[f64]) {
        self.count(list.len());
        self.0.extend(list);
    }

    fn complex(&mut self, list: &[Complex64]) {
        self.list(&list.iter().flat_map(|z| [z.re, z.im]).collect::<Vec<_>>());
    }

    fn start(&mut self, TurningPoint { displacement, time, day }: TurningPoint) {
        self.0.extend([displacement, time, day]);
    }

    /// A task, but for its checkpoint and the word to stop, with a turning point for each of its records.
    pub(crate) fn task(&mut self, task: &Task, starts: &[TurningPoint]) {
        let Task { chart, records, held, discount, discrepancy, day_deviation, strays, widened, .. } = task;
        self.0.extend([chart.amplitude, *day_deviation]);
        let Discrepancy { dissipation, frequency, allowed, .. } = *discrepancy;
        self.0.extend([dissipation, frequency, allowed]);
        self.0.extend([discrepancy.dissipation_of_level, discrepancy.frequency_of_level]);
        self.0.extend([discrepancy.dissipation_of_record, discrepancy.frequency_of_record]);
        [*strays, *widened, task.by_logarithms].into_iter().for_each(|flag| self.flag(flag));
        Parameter::ALL.iter().for_each(|parameter| self.flag(held.contains(parameter)));
        self.count(records.len());
        for (record, start) in records.iter().zip(starts) {
            self.record(record);
            self.start(*start);
        }
        let none = (DMatrix::zeros(0, 0), DVector::zeros(0));
        let (directions, weights) = discount
            .as_ref()
            .map_or((&none.0, &none.1), |discount| (&discount.directions, &discount.weights));
        self.list(directions.as_slice());
        self.list(weights.as_slice());
    }

    fn record(&mut self, record: &Windowed) {
        let Windows { omega, hop, count, tables } = record.windows;
        self.0.extend([omega, hop, record.dt, record.noise.floor, record.noise.part]);
        self.count(count);
        self.count(record.samples);
        self.count(record.quantity.power() as usize);
        [tables, record.banded].into_iter().for_each(|flag| self.flag(flag));
        self.start(record.start);
        self.list(&record.sample_noise.into_iter().collect::<Vec<_>>());
        self.complex(&record.amplitudes);
        self.complex(&record.sampling);
        [&record.deviations, &record.beside, &record.head].into_iter().for_each(|list| self.list(list));
    }
}

/// The same, read from the front; none where there is not what was written.
#[derive(Debug)]
pub(crate) struct Reader<'a>(pub(crate) &'a [f64]);

impl Reader<'_> {
    pub(crate) fn number(&mut self) -> Option<f64> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    pub(crate) fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    fn flag(&mut self) -> Option<bool> {
        self.number().map(|flag| flag != 0.0)
    }

    fn count(&mut self) -> Option<usize> {
        self.number().filter(|count| *count >= 0.0 && count.fract() == 0.0).map(|count| count as usize)
    }

    fn list(&mut self) -> Option<Vec<f64>> {
        let (list, rest) = self.count().and_then(|count| self.0.split_at_checked(count))?;
        self.0 = rest;
        Some(list.to_vec())
    }

    fn complex(&mut self) -> Option<Vec<Complex64>> {
        self.list().map(|list| list.chunks_exact(2).map(|z| Complex64::new(z[0], z[1])).collect())
    }

    fn start(&mut self) -> Option<TurningPoint> {
        self.numbers().map(|[displacement, time, day]| TurningPoint { displacement, time, day })
    }

    pub(crate) fn task(&mut self) -> Option<(Task, Vec<TurningPoint>)> {
        let [amplitude, day_deviation] = self.numbers()?;
        let [dissipation, frequency, allowed] = self.numbers()?;
        let [dissipation_of_level, frequency_of_level] = self.numbers()?;
        let [dissipation_of_record, frequency_of_record] = self.numbers()?;
        let (strays, widened, by_logarithms) = (self.flag()?, self.flag()?, self.flag()?);
        let mut held = Vec::new();
        for parameter in Parameter::ALL {
            held.extend(self.flag()?.then_some(parameter));
        }
        let (mut records, mut starts) = (Vec::new(), Vec::new());
        for _ in 0..self.count()? {
            records.push(self.record()?);
            starts.push(self.start()?);
        }
        let (directions, weights) = (self.list()?, self.list()?);
        let mut task = Task {
            chart: Chart::holding(&held, amplitude),
            records,
            held,
            discount: None,
            discrepancy: Discrepancy {
                dissipation,
                frequency,
                dissipation_of_level,
                frequency_of_level,
                dissipation_of_record,
                frequency_of_record,
                allowed,
            },
            day_deviation,
            strays,
            widened,
            by_logarithms,
            stopped: std::sync::Arc::default(),
            kept: None,
        };
        if !weights.is_empty() {
            let (rows, columns) = (task.count(), weights.len());
            if directions.len() != rows * columns {
                return None;
            }
            let directions = DMatrix::from_vec(rows, columns, directions);
            task.discount = Some(Discount { directions, weights: DVector::from_vec(weights) });
        }
        Some((task, starts))
    }

    fn record(&mut self) -> Option<Windowed> {
        let [omega, hop, dt, floor, part] = self.numbers()?;
        let (count, samples, power) = (self.count()?, self.count()?, self.count()?);
        let quantities = [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration];
        let quantity = *quantities.get(power)?;
        let (tables, banded, start) = (self.flag()?, self.flag()?, self.start()?);
        let sample_noise = self.list()?.first().copied();
        let (amplitudes, sampling) = (self.complex()?, self.complex()?);
        let (deviations, beside, head) = (self.list()?, self.list()?, self.list()?);
        if [amplitudes.len(), sampling.len(), deviations.len(), beside.len()] != [count; 4] {
            return None;
        }
        let whitening = Whitening::of(count, hop);
        let mut white = amplitudes.clone();
        whitening.apply(&mut white);
        Some(Windowed {
            windows: Windows { omega, hop, count, tables },
            whitening,
            quantity,
            dt,
            samples,
            sampling,
            amplitudes,
            white,
            noise: Noise { floor, part },
            deviations,
            start,
            banded,
            beside,
            sample_noise,
            head,
        })
    }
}
