function label(across, up)
% Labels of the current axes, without the dot between factors, which not every font has.
  xlabel(plain(across));
  ylabel(plain(up));
  set(gca, 'FontSize', 9);
end

function text = plain(text)
  text = strrep(text, char([194 183]), ' ');
  text = strrep(text, char(183), ' ');
end
