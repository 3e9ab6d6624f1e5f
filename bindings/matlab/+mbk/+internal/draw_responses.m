function handles = draw_responses(document)
% Bode plots: magnitude, phase and, if known, coherence; one column per input and output.
  if ~isfield(document, 'frequency_response') || isempty(document.frequency_response)
    error('mbk:usage', 'this result has no frequency response; plot its fields directly');
  end
  found = document.frequency_response;
  if isfield(found, 'responses')
    responses = mbk.internal.items(found.responses);
    units = units_of(found);
    titles = cellfun(@(one) [one.input ' to ' one.output], responses, 'UniformOutput', false);
    ratios = cellfun(@(one) ratio(units.(one.output), units.(one.input)), responses, 'UniformOutput', false);
  else
    responses = {found};
    titles = {[document.input.name ' to ' document.output.name]};
    ratios = {ratio(document.output.unit, document.input.unit)};
  end
  across = numel(responses);
  down = 2 + isfield(responses{1}, 'partial_coherence');
  handles = zeros(1, 0);
  for column = 1:across
    one = responses{column};
    handles(end + 1) = subplot(down, across, column);
    lowest = min(one.magnitude) / 3;
    line_with_band(found.frequency_hz, one, 'magnitude', 'magnitude_interval95', lowest);
    if lowest > 0
      set(gca, 'YScale', 'log');
      ylim([lowest, max(one.magnitude) * 3]);
    end
    label_where(column == 1 || ~strcmp(ratios{column}, ratios{1}), mbk.internal.with_unit('magnitude', ratios{column}));
    title(titles{column}, 'Interpreter', 'none', 'FontSize', 8);
    handles(end + 1) = subplot(down, across, across + column);
    line_with_band(found.frequency_hz, one, 'phase_deg', 'phase_interval95_deg', -Inf);
    label_where(column == 1, 'phase (deg)');
    if down == 3
      handles(end + 1) = subplot(down, across, 2 * across + column);
      semilogx(found.frequency_hz, one.partial_coherence, 'Color', mbk.internal.style('second'), 'LineWidth', 1.2);
      xlim([min(found.frequency_hz) max(found.frequency_hz)]);
      ylim([0 1.05]);
      grid on
      label_where(column == 1, 'partial coherence');
    end
    xlabel('frequency (Hz)');
  end
end

function label_where(shown, text)
% Labels an axis only if its label differs from the first in its row.
  set(gca, 'FontSize', 9);
  if shown
    mbk.internal.label('', text);
  end
end

function line_with_band(hz, response, value, interval, lowest)
% Clips the band at `lowest`, because a logarithmic axis has no zero.
  [colour, light] = mbk.internal.style('first');
  if isfield(response, interval) && size(response.(interval), 1) == 2
    ends = response.(interval);
    ends(ends < lowest) = lowest;
    mbk.internal.band(hz, ends(1, :), ends(2, :), light);
  end
  semilogx(hz, response.(value), 'Color', colour, 'LineWidth', 1.2);
  hold off
  set(gca, 'XScale', 'log');
  xlim([min(hz) max(hz)]);
  grid on
end

function units = units_of(found)
% Struct of units by signal name.
  units = struct();
  signals = [mbk.internal.items(found.inputs), mbk.internal.items(found.outputs)];
  for k = 1:numel(signals)
    units.(signals{k}.name) = signals{k}.unit;
  end
end

function text = ratio(above, below)
  text = above;
  if ~isempty(below)
    text = [above '/' below];
  end
end
